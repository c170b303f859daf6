// Prints what the Khronos validator says about each file; exits with 1 on any error or warning.
const { readFileSync } = require('fs');
const { createRequire } = require('module');
const validator = createRequire(process.cwd() + '/')('gltf-validator');

(async () => {
  for (const file of process.argv.slice(2)) {
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
    for (const { severity, code, message, pointer } of issues.messages)
      if (severity < 2) console.log(`  ${code} at ${pointer}: ${message}`);
    if (issues.numErrors + issues.numWarnings > 0) process.exitCode = 1;
  }
})();
