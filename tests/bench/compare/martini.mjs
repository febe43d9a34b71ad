// The martini side: a raw raster in, a PLY out, as `octaglobe mesh` writes it.
// node martini.mjs MODULE RASTER SIZE MAX_DEVIATION OUTPUT

import {closeSync, openSync, readFileSync, writeSync} from 'node:fs';

const [module, raster, size, tolerance, output] = process.argv.slice(2);
const {default: Martini} = await import(module);
const n = Number(size), bytes = readFileSync(raster);
const heights = new Int16Array(bytes.buffer, bytes.byteOffset, n * n);

const {vertices, triangles} = new Martini(n).createTile(heights).getMesh(Number(tolerance));

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
