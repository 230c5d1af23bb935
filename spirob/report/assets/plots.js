"use strict";
// Draws every figure of the page; `plots.show` lets others change one.
const plots = {
  figures: {},
  width: null, // fixed while printing, else the page decides
  config: {
    displaylogo: false,
    displayModeBar: false, // drag to zoom, double click to see all again
    responsive: true,
    plotlyServerURL: "",
    showLink: false,
    showSendToCloud: false,
  },
  show(name, figure) {
    if (figure) plots.figures[name] = figure;
    const drawn = theme.resolve(plots.figures[name]);
    const narrow = plots.width === null && innerWidth < 760;
    drawn.layout.font.family = getComputedStyle(document.body).fontFamily;
    if (narrow) drawn.layout.dragmode = false; // a finger on the plot scrolls the page
    if (narrow) drawn.layout.font.size = 12;
    if (plots.width !== null) {
      const place = document.getElementById(name);
      drawn.layout.width = place.closest(".pair") ? plots.width / 2 - 12 : plots.width;
    }
    return Plotly.react(name, drawn.data, drawn.layout, plots.config).then(legend.follow);
  },
  showAll() {
    Object.keys(plots.figures).forEach((name) => plots.show(name));
  },
};
theme.listeners.push(plots.showAll);

// On paper: light colours, figures as wide as the sheet, everything unfolded but the library, which
// would take thirty sheets.
const PAPER_WIDTH = 690;
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open]):not(.card)")];
  folded.forEach((element) => { element.open = true; });
  document.documentElement.dataset.theme = "light";
  plots.width = PAPER_WIDTH;
  theme.changed();
});
addEventListener("afterprint", () => {
  folded.forEach((element) => { element.open = false; });
  delete document.documentElement.dataset.theme;
  plots.width = null;
  theme.changed();
});
