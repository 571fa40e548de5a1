// "Try this cell": the live page, which is in this file, with the cell's scene, its own motion first.
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent), dialog = document.getElementById("live"), frame = dialog.querySelector("iframe");
  const page = read("live-page"), scenes = read("live-scenes"), data = /(<script type="application\/json" id="content">)([^<]*)/;
  let address = null;
  const open = ({ dataset: { scene } }) => {
    const content = { ...JSON.parse(data.exec(page)[2]), scene: scenes[scene], name: /^name = "([^"]*)"/m.exec(scenes[scene])?.[1] ?? scene, description: "", source: scene };
    const text = page.replace(data, (_, tag) => tag + JSON.stringify(content).replace(/</g, "\\u003c"));
    address = URL.createObjectURL(new Blob([text], { type: "text/html" }));
    frame.src = `${address}#press=1`;
    dialog.showModal();
  };
  document.querySelectorAll("button.try").forEach((button) => {
    button.hidden = false;
    button.addEventListener("click", () => open(button));
  });
  dialog.addEventListener("close", () => { frame.removeAttribute("src"); URL.revokeObjectURL(address); });
})();
