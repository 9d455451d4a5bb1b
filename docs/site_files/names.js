// Names that the theme and the notebook extension give to controls differ from the text that is seen,
// or are missing. Assistive software reads these instead.
document.addEventListener("DOMContentLoaded", () => {
  document.querySelectorAll(".search-button__button").forEach((button) => {
    button.setAttribute("aria-label", button.textContent.replace(/\s+/g, " ").trim() || "Search");
  });
  document.querySelectorAll("summary[aria-label='Toggle hidden content']").forEach((summary) => summary.removeAttribute("aria-label"));
  document.querySelectorAll(".toctree-toggle").forEach((toggle) => {
    const link = toggle.closest("li")?.querySelector("a");
    toggle.closest("summary").setAttribute("aria-label", `Pages of ${link?.textContent.trim() ?? "this section"}`);
  });
  // A table that scrolls can be scrolled with the keyboard.
  document.querySelectorAll(".bd-article-container table").forEach((table) => {
    if (table.scrollWidth > table.clientWidth) table.tabIndex = 0;
  });
});
