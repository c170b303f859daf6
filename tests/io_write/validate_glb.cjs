// Prints what the Khronos validator says about each file; exits with 1 on any message, hints included. Runs in a folder with the
// package.json and package-lock.json beside this file, and installs the validator there if it is not.
const { execFileSync } = require('child_process');
const { readFileSync } = require('fs');
const { createRequire } = require('module');

const install = 'test node_modules/.package-lock.json -nt package-lock.json || npm ci --silent --no-audit --no-fund';
execFileSync('flock', ['package.json', 'sh', '-c', install], { stdio: 'inherit' }); // once, for programs that run beside each other
const validator = createRequire(process.cwd() + '/')('gltf-validator');

(async () => {
  for (const file of process.argv.slice(2)) {
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
    console.log(`${file}: ${issues.messages.length} messages`);
    for (const { code, message, pointer } of issues.messages) console.log(`  ${code} at ${pointer}: ${message}`);
    if (issues.messages.length > 0) process.exitCode = 1;
  }
})();
