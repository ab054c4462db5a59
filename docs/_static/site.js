// Search and the choice of a version, where pages are opened from disk too.

// The summaries of search results are read from the pages, which browsers refuse from disk.
if (location.protocol === "file:") {
  DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
}

/** Put a choice in the place of the version, if versions.js names several. */
function offerVersions() {
  const versions = window.publishedVersions ?? [];
  if (versions.length < 2) return;
  const root = new URL(document.documentElement.dataset.content_root, location.href);
  const here = decodeURIComponent(root.pathname.split("/").at(-2));
  for (const place of document.querySelectorAll(".version-choice")) {
    const choice = document.createElement("select");
    choice.setAttribute("aria-label", "Version of the documentation");
    choice.append(...versions.map(({ folder }) => new Option(folder, folder, false, folder === here)));
    choice.addEventListener("change", () => {
      const { folder, pages } = versions[choice.selectedIndex];
      const page = pages.includes(place.dataset.page) ? place.dataset.page : "index";
      location.href = new URL(`../${encodeURIComponent(folder)}/${page}.html`, root);
    });
    place.replaceChildren(choice);
  }
}

/** Let the keyboard reach equations that are wider than the page, which scroll by themselves. */
function letEquationsScroll() {
  for (const equation of document.querySelectorAll(".math-block")) {
    equation.toggleAttribute("tabindex", false);
    if (equation.scrollWidth > equation.clientWidth) equation.tabIndex = 0;
  }
}

document.addEventListener("DOMContentLoaded", offerVersions);
window.addEventListener("load", letEquationsScroll);
window.addEventListener("resize", letEquationsScroll);
