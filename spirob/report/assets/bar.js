"use strict";
// The bar of sections: says which one is read, and shows its own entry where the bar is pushed.
function startBar() {
  const bar = document.querySelector("nav");
  const links = [...bar.querySelectorAll("a")];
  const sections = links.map((link) => document.getElementById(link.hash.slice(1)));
  let current = null;

  function mark() {
    document.documentElement.style.setProperty("--bar", `${bar.offsetHeight}px`);
    const line = bar.offsetHeight + 0.3 * innerHeight;
    const last = sections.findLastIndex((section) => section.getBoundingClientRect().top <= line);
    const link = links[Math.max(last, 0)];
    if (link === current) return;
    if (current) current.removeAttribute("aria-current");
    current = link;
    link.setAttribute("aria-current", "true");
    bar.scrollLeft += link.getBoundingClientRect().left - bar.clientWidth / 2;
  }
  addEventListener("scroll", mark, { passive: true });
  addEventListener("resize", mark);
  mark();
}
