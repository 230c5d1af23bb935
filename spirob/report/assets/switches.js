"use strict";
// Candidate effects as switches; every combination was computed beforehand, offline.
const switches = {
  column: "named", // whose signals are drawn: base, named (the verdict's model) or a combination
  listeners: [],
  // Signal of the chosen combination: its own, or what it changes of the base model's.
  model(signals, channel) {
    const signal = unpack(signals[`${switches.column}_${channel}`]);
    if (signal === null || switches.column === "named" || switches.column === "base") return signal;
    const base = unpack(signals[`base_${channel}`]);
    return base && base.map((value, k) => value + signal[k]);
  },
};
function startSwitches() {
  const stored = readJson("switches-data");
  const box = document.getElementById("switches-box");
  if (!stored || !box) return;
  const [error, gauge, how] = ["error", "gauge", "how"].map((name) => document.getElementById(`switches-${name}`));
  const inputs = [...box.querySelectorAll("input")];
  const key = (names) => [...names].sort().join(" ");
  const known = Object.fromEntries(stored.map((entry) => [key(entry.effects), entry]));
  const base = known[""].rmse.heldout;

  function show() {
    const entry = known[key(inputs.filter((input) => input.checked).map((input) => input.value))];
    const left = entry.rmse.heldout, any = entry.effects.length > 0;
    error.textContent = (any ? `${base.toPrecision(3)} → ` : "") + `${left.toPrecision(3)} ${box.dataset.unit}`;
    gauge.style.width = `${100 * Math.min(left / base, 1)}%`;
    how.textContent = `Computed beforehand: ${entry.how}.`;
    const figure = plots.figures.regimes;
    figure.data[1].x = figure.data[1].customdata.map((regime) => entry.regimes[regime]);
    figure.data[1].visible = any;
    plots.show("regimes");
    switches.column = entry.column;
    switches.listeners.forEach((listener) => listener());
  }
  box.addEventListener("change", show);
  show();
}
