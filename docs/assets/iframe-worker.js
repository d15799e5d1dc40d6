// Search in pages opened from disk. Browsers start no workers there, so a hidden frame does a worker's part.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      this.ready = new Promise((resolve) => this.frame.addEventListener("load", resolve, { once: true }));
      this.ready.then(() => {
        this.frame.contentWindow.postMessage = (data) => {
          const answer = new MessageEvent("message", { data });
          this.dispatchEvent(answer);
          this.onmessage?.(answer);
        };
      });
      this.frame.srcdoc = `<script src="${new URL(url, location).href}"><\/script>`;
      document.documentElement.append(this.frame);
    }

    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
