"use strict";
// Legends by keyboard: every entry takes the focus; Enter or Space hides its line and shows it again.
const legend = {
  follow(place) {
    if (!place.dataset.legend) {
      place.dataset.legend = "reachable";
      place.on("plotly_afterplot", () => legend.reach(place));
    }
    legend.reach(place);
  },
  reach(place) {
    place.querySelectorAll(".legend .traces").forEach((entry) => {
      const trace = entry.__data__[0].trace;
      entry.setAttribute("tabindex", "0");
      entry.setAttribute("role", "switch");
      entry.setAttribute("aria-label", trace.name);
      entry.setAttribute("aria-checked", String(trace.visible === true));
      entry.onkeydown = (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        legend.flip(place, trace);
      };
    });
  },
  flip(place, trace) {
    const group = trace.legendgroup;
    const all = place.data.map((_, k) => k);
    const own = all.filter((k) => k === trace.index || (group && place.data[k].legendgroup === group));
    const visible = trace.visible === true ? "legendonly" : true;
    Plotly.restyle(place, { visible }, own).then(() => {
      const entries = [...place.querySelectorAll(".legend .traces")];
      entries.find((entry) => entry.__data__[0].trace.index === trace.index)?.focus();
    });
  },
};
