"use strict";
// Fills the overlay figure with the chosen trial and channel.
function startOverlay() {
  const stored = readJson("overlay-data");
  const choice = document.getElementById("overlay-trial");
  const channels = document.getElementById("overlay-channel");
  if (!stored || !choice) return;
  const empty = readJson("overlay-figure");
  stored.trials.forEach((trial, k) => {
    choice.add(new Option(trial.role === "train" ? `${trial.name} (training)` : trial.name, k));
  });

  function fill() {
    const trial = stored.trials[choice.value];
    const channel = channels.querySelector(":checked").value;
    const figure = structuredClone(empty);
    for (const trace of figure.data) {
      const signals = (trial.motors[trace.meta.motor] || { signals: {} }).signals;
      const signal = unpack(signals[`${trace.meta.origin}_${channel}`]);
      const minus = trace.meta.minus && unpack(signals[`${trace.meta.minus}_${channel}`]);
      trace.visible = signal !== null && minus !== null;
      if (!trace.visible) continue;
      trace.x = unpack(signals.time);
      trace.y = minus ? signal.map((value, k) => value - minus[k]) : signal;
    }
    const motors = [...new Set(figure.data.map((trace) => trace.meta.motor))];
    motors.forEach((motor, row) => {
      const entry = trial.motors[motor];
      const axis = (k) => figure.layout[k === 1 ? "yaxis" : `yaxis${k}`];
      figure.layout.annotations[2 * row].text = `<b>${motor} motor</b>, ${channel}`;
      figure.layout.annotations[2 * row + 1].text = entry ? entry.errors[channel] : "not recorded";
      axis(2 * row + 1).title = { text: stored.units[channel] };
      axis(2 * row + 2).title = { text: `residual ${stored.units[channel]}` };
    });
    plots.show("overlay", figure);
  }
  choice.addEventListener("change", fill);
  channels.addEventListener("change", fill);
  choice.value = 0;
  fill();
}
