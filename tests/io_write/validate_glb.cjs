// Prints what the Khronos validator says about each file; exits with 1 on any message, hints included.
const { readFileSync } = require('fs');
const { createRequire } = require('module');
const validator = createRequire(process.cwd() + '/')('gltf-validator');

(async () => {
  for (const file of process.argv.slice(2)) {
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
    console.log(`${file}: ${issues.messages.length} messages`);
    for (const { code, message, pointer } of issues.messages) console.log(`  ${code} at ${pointer}: ${message}`);
    if (issues.messages.length > 0) process.exitCode = 1;
  }
})();
