// Buttons that copy LaTeX. Pages that are served without encryption have no clipboard.
document.addEventListener("click", async (event) => {
  const button = event.composedPath().find((e) => e.matches?.("button.copy"));
  if (!button) return;
  const text = button.dataset.latex;
  const label = (button.dataset.label ??= button.textContent);
  let copied = true;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = document.createElement("textarea");
    field.value = text;
    document.body.append(field);
    field.select();
    copied = document.execCommand("copy");
    field.remove();
    button.focus();
  }
  button.textContent = copied ? button.dataset.copied : button.dataset.failed;
  setTimeout(() => { button.textContent = label; }, 1500);
});
