// node draco3d.js FOLDER: decodes FOLDER/*.drc with npm's draco3d and prints, per file in the order
// of their names, "NAME POINTS ATTRIBUTES FACES SUM", SUM over all values of all attributes and all
// corners, each times its place modulo 97.
const fs = require('fs');
const path = require('path');
const draco3d = require('draco3d');

// The values of the attribute at every point.
function read(module, decoder, geometry, attribute) {
  const isFloat = attribute.data_type() === module.DT_FLOAT32;
  const values = isFloat ? new module.DracoFloat32Array() : new module.DracoInt32Array();
  if (isFloat) {
    decoder.GetAttributeFloatForAllPoints(geometry, attribute, values);
  } else {
    decoder.GetAttributeInt32ForAllPoints(geometry, attribute, values);
  }
  return values;
}

draco3d.createDecoderModule({}).then((module) => {
  const folder = process.argv[2];
  for (const name of fs.readdirSync(folder).filter((n) => n.endsWith('.drc')).sort()) {
    const bytes = new Int8Array(fs.readFileSync(path.join(folder, name)));
    const buffer = new module.DecoderBuffer();
    buffer.Init(bytes, bytes.length);
    const decoder = new module.Decoder();
    const isMesh = decoder.GetEncodedGeometryType(buffer) === module.TRIANGULAR_MESH;
    const geometry = isMesh ? new module.Mesh() : new module.PointCloud();
    const status = isMesh ? decoder.DecodeBufferToMesh(buffer, geometry)
                          : decoder.DecodeBufferToPointCloud(buffer, geometry);
    if (!status.ok()) throw new Error(`${name}: ${status.error_msg()}`);
    let sum = 0;
    for (let a = 0; a < geometry.num_attributes(); ++a) {
      const values = read(module, decoder, geometry, decoder.GetAttribute(geometry, a));
      for (let i = 0; i < values.size(); ++i) sum += (i % 97 + 1) * values.GetValue(i);
    }
    const numFaces = isMesh ? geometry.num_faces() : 0;
    const face = new module.DracoInt32Array();
    for (let f = 0; f < numFaces; ++f) {
      decoder.GetFaceFromMesh(geometry, f, face);
      for (let c = 0; c < 3; ++c) sum += ((3 * f + c) % 97 + 1) * face.GetValue(c);
    }
    console.log(`${name} ${geometry.num_points()} ${geometry.num_attributes()} ${numFaces} ` +
                sum.toFixed(3));
  }
});
