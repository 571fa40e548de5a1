// Texts and numbers in the memory of the WebAssembly module. When the memory grows, its buffer is replaced, so every access makes
// a new view of the buffer.
let wasm;

const text = (address, bytes) => new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, address, bytes));
const given = () => text(wasm.live_text(), wasm.live_text_bytes());

function put(string) {
  const bytes = new TextEncoder().encode(string);
  const room = wasm.live_text_room(bytes.length);
  new Uint8Array(wasm.memory.buffer, room, bytes.length).set(bytes);
}

function numbers(address, n) {
  return new Float64Array(wasm.memory.buffer, address, n);
}
