// Inflates the modules of the page and starts the viewer. A page from the disk may not import files,
// so each module becomes a blob URL that an import map names.

// Deflated bytes in base64 as a Response; viewer.js unpacks its motions with it too.
globalThis.inflated = (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")));
};

(async () => {
  const packed = JSON.parse(document.getElementById("viewer-modules").textContent);
  const imports = {};
  for (const [name, text] of Object.entries(packed)) {
    const source = await inflated(text).text();
    imports[name] = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  }
  const map = document.createElement("script");
  map.type = "importmap";
  map.textContent = JSON.stringify({ imports });
  document.head.append(map);
  for (const name of Object.keys(imports)) await import(name);
})();
