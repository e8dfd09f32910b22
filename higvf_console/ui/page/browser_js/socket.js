// Runs in the page's head, ahead of viser: hands in the page's key with its socket, and says why it was refused one.
(store) => {
  const UNSAID = "Connection closed"; // viser's own word where the server gave no reason

  const key = localStorage.getItem(store);
  if (!key) location.replace("./?login=1");

  const notice = document.createElement("p");
  notice.setAttribute("role", "alert");
  notice.style.cssText =
    "position:fixed;z-index:2147483647;left:50%;top:38%;transform:translateX(-50%);box-sizing:border-box;margin:0;" +
    "width:max-content;max-width:min(34em,92vw);padding:14px 20px;border-radius:10px;border-left:5px solid #e69f00;" +
    "font:16px/1.5 system-ui,sans-serif;color:#fff;background:#242a33;box-shadow:0 8px 32px rgba(0,0,0,.5)";

  function say(text) {
    notice.textContent = text;
    if (text) document.body.append(notice);
    else notice.remove();
  }

  // A browser does not tell a page how its socket was refused, so the page asks. A server that has gone gives no answer.
  async function explain(reason) {
    const answer = await fetch("./?seat=1").catch(() => null);
    if (answer?.status === 401) say("The login of this page has ended: open the console by its link again.");
    else if (answer?.status === 503) say(await answer.text());
    else if (reason !== UNSAID) say(reason);
  }

  // viser opens its socket in a worker, which it tells the address.
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...rest) {
    if (message?.type === "set_server") {
      message = { ...message, server: `${message.server}/?key=${key}` };
      this.addEventListener("message", ({ data }) => {
        if (data?.type === "connected") say("");
        else if (data?.type === "closed") explain(data.closeReason);
      });
    }
    return post.call(this, message, ...rest);
  };
}
