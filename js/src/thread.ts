// The program of a worker of a module with threads.
import { runThread, type ThreadStart } from './threads.js';

if (typeof self === 'object' && typeof postMessage === 'function') {
  self.onmessage = (event: MessageEvent<ThreadStart>) => void runThread(event.data, () => postMessage('ready'));
} else {
  const { parentPort } = await import('node:worker_threads');
  parentPort!.once('message', (start: ThreadStart) => void runThread(start, () => parentPort!.postMessage('ready')));
}
