// What a mesh has achieved, by brute force: the vertical distance of every sample from every triangle that holds it.
// node deviation.mjs RASTER SIZE MESH.ply     prints JSON: triangles, max_m, uncovered (samples in no triangle),
//     upright (triangles without area in plan)
//
// Knows nothing of bisection: vertices are (column, -row, height), triangles anything with corners on samples.

import {readFileSync} from 'node:fs';

const [raster, size, mesh] = process.argv.slice(2);
const n = Number(size), raw = readFileSync(raster);
const heights = new Int16Array(raw.buffer, raw.byteOffset, n * n);

const file = readFileSync(mesh);
const body = file.indexOf('end_header\n') + 'end_header\n'.length;
const header = file.toString('latin1', 0, body);
const count = (element) => Number(header.match(new RegExp(`element ${element} (\\d+)`))[1]);
const vertices = count('vertex'), triangles = count('face');
if (!/property double x\nproperty double y\nproperty double z\nelement face/.test(header)) throw Error('another layout');
const view = new DataView(file.buffer, file.byteOffset + body);
const column = new Int32Array(vertices), row = new Int32Array(vertices), height = new Float64Array(vertices);
for (let v = 0; v < vertices; ++v) {
    const x = view.getFloat64(24 * v, true), y = -view.getFloat64(24 * v + 8, true);
    if (x !== Math.round(x) || y !== Math.round(y) || x < 0 || y < 0 || x >= n || y >= n)
        throw Error(`vertex ${v} lies on no sample`);
    column[v] = x;
    row[v] = y;
    height[v] = view.getFloat64(24 * v + 16, true);
}

const covered = new Uint8Array(n * n);
let upright = 0;
const worstIn = (a, b, c) => {
    const ax = column[a], ay = row[a];
    let bx = column[b] - ax, by = row[b] - ay, cx = column[c] - ax, cy = row[c] - ay, hb = height[b], hc = height[c];
    if (bx * cy - by * cx < 0) [bx, by, cx, cy, hb, hc] = [cx, cy, bx, by, hc, hb];
    const area = bx * cy - by * cx, ha = height[a];
    let worst = 0;
    if (area === 0) {
        ++upright;
        return 0;
    }
    for (let y = Math.min(0, by, cy); y <= Math.max(0, by, cy); ++y)
        for (let x = Math.min(0, bx, cx); x <= Math.max(0, bx, cx); ++x) {
            const ofB = x * cy - y * cx, ofC = bx * y - by * x, ofA = area - ofB - ofC;
            if (ofA < 0 || ofB < 0 || ofC < 0) continue;
            const at = (ay + y) * n + ax + x;
            covered[at] = 1;
            worst = Math.max(worst, Math.abs((ofA * ha + ofB * hb + ofC * hc) / area - heights[at]));
        }
    return worst;
};

let max = 0;
for (let t = 0, at = 24 * vertices; t < triangles; ++t, at += 13) {
    if (view.getUint8(at) !== 3) throw Error('a polygon that is no triangle');
    max = Math.max(max, worstIn(view.getInt32(at + 1, true), view.getInt32(at + 5, true), view.getInt32(at + 9, true)));
}
console.log(JSON.stringify({triangles, max_m: max, uncovered: covered.reduce((sum, c) => sum - c, n * n), upright}));
