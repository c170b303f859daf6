// Headless Chromium by playwright-core of SDM_NODE_PACKAGES.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { delimiter, join } from 'node:path';

/** `others`: further switches. */
export function launched(others = []) {
  const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, 'chromium-headless-shell')).find(existsSync);
  assert(executablePath, 'chromium-headless-shell is needed for this test (Debian package of that name)');
  const { chromium } = createRequire(process.env.SDM_NODE_PACKAGES + '/')('playwright-core');
  return chromium.launch({ executablePath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', ...others] });
}
