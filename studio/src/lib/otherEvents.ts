// A pause of long work.

const { port1, port2 } = new MessageChannel();
const waiting: (() => void)[] = [];
port1.onmessage = () => waiting.shift()?.();

/** The page handles events and draws in between; timers would wait at least 4 ms. */
export const otherEvents = (): Promise<void> =>
  new Promise((next) => {
    waiting.push(next);
    port2.postMessage(null);
  });
