// Buttons that save the picture before them as SVG or PNG.
(() => {
  "use strict";
  // Pixels of a saved PNG for each unit of the picture.
  const FINE = 3;
  const named = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "picture";

  function download(href, name) {
    const link = document.createElement("a");
    link.href = href;
    link.download = name;
    document.body.append(link);
    link.click();
    link.remove();
  }
  const address = (text) => "data:image/svg+xml;charset=utf-8," + encodeURIComponent(text);

  // The text of an svg element as a file of its own.
  function file(svg) {
    const copy = svg.cloneNode(true);
    const box = svg.viewBox.baseVal;
    const scale = Math.max(1, 400 / box.width);
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.setAttribute("width", box.width * scale);
    copy.setAttribute("height", box.height * scale);
    copy.removeAttribute("class");
    return new XMLSerializer().serializeToString(copy);
  }
  async function save(text, kind, name) {
    if (kind === "svg") { download(address(text), name + ".svg"); return; }
    const image = new Image();
    image.src = address(text);
    await image.decode();
    const sheet = document.createElement("canvas");
    sheet.width = FINE * image.width;
    sheet.height = FINE * image.height;
    const pen = sheet.getContext("2d");
    pen.fillStyle = "#fff";
    pen.fillRect(0, 0, sheet.width, sheet.height);
    pen.drawImage(image, 0, 0, sheet.width, sheet.height);
    download(sheet.toDataURL("image/png"), name + ".png");
  }

  document.addEventListener("click", (event) => {
    const button = event.composedPath().find((e) => e.matches?.("button[data-save]"));
    if (!button) return;
    event.stopImmediatePropagation();
    // A picture on a canvas writes its own SVG.
    const drawn = window.pictureAsSvg?.();
    const svg = drawn ? null : button.parentElement.previousElementSibling;
    save(drawn ?? file(svg), button.dataset.save, named(drawn ? document.title : svg.getAttribute("aria-label") ?? ""));
  });
})();
