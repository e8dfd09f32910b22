// Tells the server which notification the operator has put away; one that fades by itself has not been read.
(page) => {
  function onClick(event) {
    const note = event.target.closest?.(".mantine-Notification-closeButton")?.closest(".mantine-Notification-root");
    const text = note?.querySelector(".mantine-Notification-description")?.textContent;
    if (text) page.send("read", { text });
  }

  return { remove: page.listen({ click: onClick }) };
}
