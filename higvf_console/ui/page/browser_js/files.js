// Files from the operator's computer: chosen in the page, sent in pieces.
(page, config) => {
  async function send(kind, file) {
    if (file.size > config.most) return page.send("file", { kind, name: file.name, size: file.size, part: 0, parts: 0, content: "" });
    const bytes = new Uint8Array(await file.arrayBuffer());
    const parts = Math.max(1, Math.ceil(bytes.length / config.piece));
    for (let part = 0; part < parts; part++) {
      const piece = bytes.subarray(part * config.piece, (part + 1) * config.piece);
      let text = "";
      for (let start = 0; start < piece.length; start += 8192)
        text += String.fromCharCode(...piece.subarray(start, start + 8192));
      page.send("file", { kind, name: file.name, size: file.size, part, parts, content: btoa(text) });
    }
  }

  const input = document.createElement("input");
  input.type = "file";
  input.hidden = true;
  document.body.append(input);
  let wanted = "";
  input.addEventListener("change", () => {
    if (input.files.length) send(wanted, input.files[0]);
    input.value = "";
  });

  return {
    choose({ kind, accept }) {
      wanted = kind;
      input.accept = accept;
      input.click();
    },
    remove: () => input.remove(),
  };
}
