// node delta_stream_node.js FOLDER: decodes FOLDER/*.drc with npm's draco3d and prints, per file in
// the order of their names, "NAME POINTS ATTRIBUTES SUM", SUM over all values of all attributes.
const fs = require('fs');
const path = require('path');
const draco3d = require('draco3d');

draco3d.createDecoderModule({}).then((module) => {
  const folder = process.argv[2];
  for (const name of fs.readdirSync(folder).filter((n) => n.endsWith('.drc')).sort()) {
    const bytes = new Int8Array(fs.readFileSync(path.join(folder, name)));
    const buffer = new module.DecoderBuffer();
    buffer.Init(bytes, bytes.length);
    const decoder = new module.Decoder();
    const cloud = new module.PointCloud();
    const status = decoder.DecodeBufferToPointCloud(buffer, cloud);
    if (!status.ok()) throw new Error(`${name}: ${status.error_msg()}`);
    let sum = 0;
    for (let a = 0; a < cloud.num_attributes(); ++a) {
      const attribute = decoder.GetAttribute(cloud, a);
      const isFloat = attribute.data_type() === module.DT_FLOAT32;
      const values = isFloat ? new module.DracoFloat32Array() : new module.DracoInt32Array();
      if (isFloat) {
        decoder.GetAttributeFloatForAllPoints(cloud, attribute, values);
      } else {
        decoder.GetAttributeInt32ForAllPoints(cloud, attribute, values);
      }
      for (let i = 0; i < values.size(); ++i) sum += (i % 97 + 1) * values.GetValue(i);
    }
    console.log(`${name} ${cloud.num_points()} ${cloud.num_attributes()} ${sum.toFixed(3)}`);
  }
});
