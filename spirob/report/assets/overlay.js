"use strict";
// Fills the overlay figure with the chosen trial and channel, marks a regime, shows the moment.
function startOverlay() {
  const stored = readJson("overlay-data");
  const [choice, channels, regime, marked] = ["trial", "channel", "regime", "marked"].map(
    (name) => document.getElementById(`overlay-${name}`));
  if (!stored || !choice) return;
  const place = document.getElementById("overlay");
  const empty = readJson("overlay-figure");
  const cursor = document.createElement("div");
  cursor.className = "cursor";
  stored.trials.forEach((trial, k) => {
    choice.add(new Option(trial.role === "train" ? `${trial.name} (training)` : trial.name, k));
  });

  function fill() {
    const trial = stored.trials[choice.value];
    const channel = channels.querySelector(":checked").value;
    const figure = structuredClone(empty);
    for (const trace of figure.data) {
      const signals = (trial.motors[trace.meta.motor] || { signals: {} }).signals;
      const signal = trace.meta.origin === "named"
        ? switches.model(signals, channel) : unpack(signals[`${trace.meta.origin}_${channel}`]);
      if (trace.meta.origin === "named" && switches.column !== "named") trace.name = "with the switched effects";
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
      figure.layout.annotations[2 * row + 1].text = entry ? errors(entry, channel) : "not recorded";
      axis(2 * row + 1).title = { text: stored.units[channel] };
      axis(2 * row + 2).title = { text: `residual ${stored.units[channel]}` };
    });
    figure.layout.shapes = marks(trial, motors);
    return plots.show("overlay", figure).then(point);
  }
  function errors(entry, channel) {
    let text = entry.errors[channel];
    if (switches.column !== "named") { // from the samples drawn; the others are from all of them
      const [measured, base, model] = [unpack(entry.signals[`measured_${channel}`]),
        unpack(entry.signals[`base_${channel}`]), switches.model(entry.signals, channel)];
      const rms = (signal) => Math.sqrt(signal.reduce((sum, v, k) => sum + (v - measured[k]) ** 2, 0) / signal.length);
      if (measured && base && model) text = `residual RMSE: base ${rms(base).toPrecision(3)}, switched ${rms(model).toPrecision(3)} ${stored.units[channel].slice(1, -1)}`;
    }
    return innerWidth < 760 ? text.replace("residual ", "") : text;
  }
  function marks(trial, motors) {
    let total = 0;
    const shapes = motors.flatMap((motor, row) => {
      const spans = ((trial.motors[motor] || {}).regimes || {})[regime.value] || [];
      return spans.flatMap(([from, to]) => {
        total += to - from;
        return [2 * row + 1, 2 * row + 2].map((k) => ({
          type: "rect", xref: "x", yref: `${k === 1 ? "y" : `y${k}`} domain`, x0: from, x1: to, y0: 0, y1: 1,
          fillcolor: "var(--base)", opacity: 0.2, line: { width: 0 }, layer: "below",
        }));
      });
    });
    marked.textContent = regime.value ? `${total.toFixed(1)} s of this trial` : "";
    return shapes;
  }
  // A thin line at the moment; an element of its own, as redrawing the plots is slow.
  function point() {
    const layout = place._fullLayout;
    const here = layout && stored.trials[choice.value].name === moment.trial && moment.seconds !== null;
    const [low, high] = here ? layout.xaxis.range : [0, 0];
    cursor.hidden = !here || moment.seconds < low || moment.seconds > high;
    if (cursor.hidden) return;
    if (!cursor.isConnected) place.append(cursor);
    const share = (moment.seconds - low) / (high - low);
    cursor.style.left = `${layout._size.l + share * layout._size.w}px`;
    cursor.style.top = `${layout._size.t}px`;
    cursor.style.height = `${layout._size.h}px`;
  }
  function follow(source) {
    const k = stored.trials.findIndex((entry) => entry.name === moment.trial);
    if (source === "arm" && k >= 0 && String(k) !== choice.value) { choice.value = k; fill(); }
    point();
  }
  function mark(name) {
    regime.value = regime.value === name ? "" : name;
    fill();
    if (regime.value) document.getElementById("overlay-title").scrollIntoView();
  }
  choice.addEventListener("change", () => {
    fill();
    moment.set(stored.trials[choice.value].name, null, "overlay");
  });
  channels.addEventListener("change", fill);
  regime.addEventListener("change", fill);
  moment.listeners.push(follow);
  switches.listeners.push(fill);
  choice.value = 0;
  fill().then(() => {
    place.on("plotly_click", (event) => {
      moment.set(stored.trials[choice.value].name, event.points[0].x, "overlay");
    });
    place.on("plotly_afterplot", point);
    const atlas = document.getElementById("atlas");
    if (atlas && atlas.on) atlas.on("plotly_click", (event) => mark(event.points[0].customdata));
  });
}
