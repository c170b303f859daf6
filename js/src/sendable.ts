// What can be sent to a worker.
/** Copies arrays, or lets them be moved; everything else that can be sent stays. */
export function sendable(value: unknown, transfer: boolean, moved: Set<Transferable>): unknown {
  if (ArrayBuffer.isView(value) || value instanceof ArrayBuffer) {
    const buffer = value instanceof ArrayBuffer ? value : value.buffer;
    const movable = transfer && buffer instanceof ArrayBuffer && buffer.byteLength === value.byteLength;
    const sent = movable ? value : copied(value);
    moved.add(sent instanceof ArrayBuffer ? sent : (sent.buffer as ArrayBuffer));
    return sent;
  }
  if (Array.isArray(value))
    return typeof value[0] === 'object'
      ? value.map((item) => sendable(item, transfer, moved))
      : value.slice();
  if (value && typeof value === 'object')
    return Object.fromEntries(
      Object.entries(value).map(([name, item]) => [name, sendable(item, transfer, moved)]),
    );
  return value;
}

/** A copy with a buffer of its own. The slice() of Node's Buffer is none: that is another view of the same memory. */
function copied(value: ArrayBuffer | ArrayBufferView): ArrayBuffer | ArrayBufferView {
  if (value instanceof ArrayBuffer) return value.slice(0);
  const bytes = new Uint8Array(value.byteLength);
  bytes.set(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
  // The type of its elements, such as `Uint8Array` of a Buffer, whose own constructor is another one.
  const type = Object.prototype.toString.call(value).slice(8, -1) as 'Uint8Array';
  return new globalThis[type](bytes.buffer);
}
