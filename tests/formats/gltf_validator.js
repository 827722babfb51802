// node gltf_validator.js FILE: prints "ERRORS WARNINGS", as Khronos's glTF validator counts them, and
// then its messages.
const fs = require('fs');
const validator = require('gltf-validator');

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then((report) => {
  console.log(`${report.issues.numErrors} ${report.issues.numWarnings}`);
  for (const message of report.issues.messages.filter((m) => m.severity < 2).slice(0, 20)) {
    console.log(`${message.code} ${message.pointer}: ${message.message}`);
  }
});
