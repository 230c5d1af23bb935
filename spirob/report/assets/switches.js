"use strict";
// Candidate effects as switches; every combination was computed beforehand, offline.
const switches = {
  weights: null, // null: the model of the verdict, fitted to the end
  listeners: [],
  // Signal of the chosen combination from those of the base model and of each effect alone.
  model(signals, channel) {
    const base = unpack(signals[`base_${channel}`]);
    if (switches.weights === null) return unpack(signals[`named_${channel}`]);
    const parts = Object.entries(switches.weights).map(([name, weight]) => [
      unpack(signals[`${name}_${channel}`]), weight]);
    if (base === null || parts.some(([signal]) => signal === null)) return null;
    return base.map((value, k) => parts.reduce((sum, [signal, weight]) => sum + weight * (signal[k] - value), value));
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
  const name = (value) => inputs.find((input) => input.value === value).parentElement.textContent.trim();

  function show() {
    const entry = known[key(inputs.filter((input) => input.checked).map((input) => input.value))];
    const left = entry.rmse.heldout, any = entry.effects.length > 0;
    error.textContent = (any ? `${base.toPrecision(3)} → ` : "") + `${left.toPrecision(3)} mA`;
    gauge.style.width = `${100 * Math.min(left / base, 1)}%`;
    how.textContent = `Computed beforehand: ${entry.how}.`;
    if (entry.how === "first order") {
      const shares = entry.effects.map((effect) => `${name(effect)} ${entry.weights[effect].toFixed(2)}`);
      how.textContent += ` What each does alone in full simulation, in shares that fit the validation trials: ${shares.join(", ")}.`;
    }
    const figure = plots.figures.regimes;
    figure.data[1].x = figure.data[1].customdata.map((regime) => entry.regimes[regime]);
    figure.data[1].visible = any;
    plots.show("regimes");
    switches.weights = entry.weights;
    switches.listeners.forEach((listener) => listener());
  }
  box.addEventListener("change", show);
  show();
}
