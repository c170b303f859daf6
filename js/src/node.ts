// The package in Node.
import { node } from './node_platform.js';
import { setPlatform } from './platform.js';

setPlatform(node);
export * from './index.js';
