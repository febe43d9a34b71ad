// A peer's mesh of a raw raster, as a PLY like those of `octaglobe mesh`: vertices are (column, -row, height).
// node peer.mjs MODULES NAME RASTER SIZE MAX_DEVIATION OUTPUT [TRIANGLES]
//     prints JSON: seconds and processor seconds that the mesh took, without reading and writing
//
// martini and delatin stop at a deviation; the simplifier of meshoptimizer at a number of triangles, for its own bound is
// of no vertical distance.

import {closeSync, openSync, readFileSync, writeSync} from 'node:fs';
import {join} from 'node:path';

const [modules, name, raster, size, tolerance, output, target] = process.argv.slice(2);
const n = Number(size), bytes = readFileSync(raster);
const heights = new Int16Array(bytes.buffer, bytes.byteOffset, n * n);
const load = (file) => import(join(modules, file));

/** Vertices (x, y), by default those of the raster, and triangles: three of their numbers each. */
const peers = {
    async martini() {
        const {default: Martini} = await load('@mapbox/martini/martini.js');
        return () => new Martini(n).createTile(heights).getMesh(Number(tolerance));
    },
    async delatin() {
        const {default: Delatin} = await load('delatin/index.js');
        return () => {
            const tin = new Delatin(heights, n);
            tin.run(Number(tolerance));
            return {vertices: tin.coords, triangles: tin.triangles};
        };
    },
    async meshoptimizer() {
        const {MeshoptSimplifier} = await load('meshoptimizer/index.js');
        await MeshoptSimplifier.ready;
        const metres = 82.6;  // a sample of 3" at 37.5 degrees north, along and across
        const places = new Float32Array(3 * n * n), all = new Uint32Array(6 * (n - 1) * (n - 1));
        for (let y = 0, v = 0, i = 0; y < n; ++y)
            for (let x = 0; x < n; ++x, ++v) {
                places.set([metres * x, metres * y, heights[v]], 3 * v);
                if (x + 1 === n || y + 1 === n) continue;
                all.set([v, v + n, v + 1, v + 1, v + n, v + n + 1], i);
                i += 6;
            }
        return () => {
            const [triangles] =
                MeshoptSimplifier.simplify(all, places, 3, 3 * Number(target), 1e9, ['LockBorder', 'ErrorAbsolute']);
            const number = new Uint32Array(n * n), vertices = [];
            for (let i = 0; i < triangles.length; ++i) {
                const v = triangles[i];
                if (number[v] === 0) {
                    vertices.push(v % n, Math.floor(v / n));
                    number[v] = vertices.length / 2;
                }
                triangles[i] = number[v] - 1;
            }
            return {vertices, triangles};
        };
    }
};

const run = await peers[name]();
const before = process.cpuUsage(), start = process.hrtime.bigint();
const {vertices, triangles} = run();
const seconds = Number(process.hrtime.bigint() - start) / 1e9, used = process.cpuUsage(before);

const places = new Float64Array(vertices.length / 2 * 3);
for (let v = 0; v < vertices.length / 2; ++v) {
    const x = vertices[2 * v], y = vertices[2 * v + 1];
    places[3 * v] = x;
    places[3 * v + 1] = -y;
    places[3 * v + 2] = heights[y * n + x];
}
const faces = new DataView(new ArrayBuffer(triangles.length / 3 * 13));
for (let t = 0; t < triangles.length / 3; ++t) {
    faces.setUint8(13 * t, 3);
    for (let k = 0; k < 3; ++k) faces.setInt32(13 * t + 1 + 4 * k, triangles[3 * t + k], true);
}
const file = openSync(output, 'w');
const write = (data) => {
    for (let at = 0; at < data.byteLength;) at += writeSync(file, data, at);
};
write(Buffer.from(`ply
format binary_little_endian 1.0
element vertex ${places.length / 3}
property double x
property double y
property double z
element face ${triangles.length / 3}
property list uchar int vertex_indices
end_header
`));
write(new Uint8Array(places.buffer));
write(new Uint8Array(faces.buffer));
closeSync(file);
console.log(JSON.stringify({seconds, processor: (used.user + used.system) / 1e6}));
