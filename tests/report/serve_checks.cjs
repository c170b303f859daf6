// Runs checks for a test program, all in one browser: each line of stdin is the JSON of [PROGRAM, CHECK, PAGE, ARGUMENT...], with the
// program "page" or "looks", and is answered by a line, the JSON of what is wrong, or null. Ends when stdin does.
const { createInterface } = require('readline');
const { checked, launched } = require('./checks/browser.cjs');

const programs = { page: require('./check_page.cjs'), looks: require('./check_looks.cjs') };
console.log = console.error; // answers alone are on stdout

let browser = null;
/// What is wrong, by a check in the browser; in a new one if there is none, or the last one has died.
async function faultOf([program, ...request]) {
  try {
    if (!browser?.isConnected()) browser = await launched();
    await checked(browser, (...given) => programs[program].run(...given, ...request));
    return null;
  } catch (error) {
    return error.stack || String(error); // of a browser that died, no stack is known
  }
}

async function serve() {
  const lines = createInterface({ input: process.stdin });
  // Also in the middle of a check, when the test program has been killed.
  lines.on('close', async () => {
    await browser?.close();
    process.exit();
  });
  process.stdout.on('error', () => {}); // nobody reads any more
  for await (const line of lines) process.stdout.write(`${JSON.stringify(await faultOf(JSON.parse(line)))}\n`);
}
void serve();
