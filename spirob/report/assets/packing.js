"use strict";
// The other half of figures.py: 16-bit or, coarse, 8-bit integers in base64 to numbers.
function readJson(id) {
  const element = document.getElementById(id);
  return element ? JSON.parse(element.textContent) : null;
}
function unpack(packed) {
  if (!packed) return null;
  const bytes = Uint8Array.from(atob(packed.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const most = packed.coarse ? 127 : 32767;
  const signal = new Float64Array(packed.coarse ? bytes.length : bytes.length / 2);
  for (let k = 0; k < signal.length; k++) {
    const level = packed.coarse ? view.getInt8(k) : view.getInt16(2 * k, true);
    signal[k] = level === -most - 1 ? NaN : packed.low + packed.step * (level + most);
  }
  return signal;
}
