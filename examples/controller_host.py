"""A host: moves the wafers of a cassette through a simulated controller, and prints the time of each command.

    jointplay cell serve --speed 100
    python3 controller_host.py 127.0.0.1:7000 LP1 LP2 A 3
"""

import socket
import sys


class Controller:
    """A connection to a controller that speaks the neutral language."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=60)
        self.lines = self.socket.makefile("r", encoding="utf-8", newline="\n")
        self.welcome = self.lines.readline().strip()

    def execute(self, command):
        """Sends a command, waits for its end, and returns the duration of its motion (s)."""
        self.socket.sendall(f"{command}\n".encode())
        for expected in ("ACCEPTED", "COMPLETED"):
            word, _, rest = self.lines.readline().strip().partition(" ")
            if word != expected:
                raise RuntimeError(f"{command}: {word} {rest}")
        return float(rest.split(" ")[0])

    def ask(self, command):
        """Sends a question and returns its answer."""
        self.socket.sendall(f"{command}\n".encode())
        return self.lines.readline().strip()


def main(address, source, target, effector, count):
    controller = Controller(address)
    print(controller.welcome)
    total = 0.0
    for slot in range(1, int(count) + 1):
        for command in (f"GET {source} {slot} {effector}", f"PUT {target} {slot} {effector}"):
            duration = controller.execute(command)
            total += duration
            print(f"{duration:8.3f} s  {command}")
    print(f"{total:8.3f} s  in all")
    print(controller.ask(f"MAP {target}"))


if __name__ == "__main__":
    main(*sys.argv[1:])
