"""A GEM host: transfers wafers of a cassette by remote commands to equipment such as gem_equipment.py.

    python3 gem_host.py 5000 LP1 LP2 A 3
"""

import queue
import sys
import time

import secsgem.common
import secsgem.gem
import secsgem.hsms

STATUS, RESULT, DURATION, TRANSFER_FINISHED = 10, 30, 31, 1000
ACK_FINISH_LATER = 4
# Least time between connections, T5 of HSMS: equipment first has to notice that the last one ended.
SEPARATION_S = 1.0


class Host(secsgem.gem.GemHostHandler):
    """A host that waits for the event after each transfer."""

    def __init__(self, port):
        settings = secsgem.hsms.HsmsSettings(
            address="127.0.0.1",
            port=port,
            connect_mode=secsgem.hsms.HsmsConnectMode.ACTIVE,
            device_type=secsgem.common.DeviceType.HOST,
        )
        super().__init__(settings)
        self.finished = queue.Queue()
        self.events.collection_event_received += self.received

    def received(self, data):
        values = {value["dvid"]: value["value"] for value in data["values"]}
        self.finished.put((values[RESULT], values[DURATION]))

    def connect(self, attempts=4, wait=5.0):
        """Opens the connection, again if the first message was lost: secsgem drops one that overtakes the state of the connection."""
        for _ in range(attempts):
            self.enable()
            if self.waitfor_communicating(wait):
                return
            self.disable()
            time.sleep(SEPARATION_S)
        raise RuntimeError("the equipment does not answer")

    def status(self):
        """The answer of the robot's controller to STATUS."""
        answer = self.settings.streams_functions.decode(self.send_and_waitfor_response(self.stream_function(1, 3)([STATUS])))
        return answer[0].get()

    def transfer(self, **parameters):
        """Moves a wafer; returns the result and the duration (s)."""
        answer = self.send_remote_command("TRANSFER", [[name, str(value)] for name, value in parameters.items()])
        code = answer.HCACK.get()
        if code != ACK_FINISH_LATER:
            raise RuntimeError(f"the equipment does not accept the command: HCACK {code}")
        return self.finished.get(timeout=60)


def main(port, source, target, effector, count):
    host = Host(int(port))
    host.connect()
    host.go_online()
    host.subscribe_collection_event(TRANSFER_FINISHED, [RESULT, DURATION])
    total = 0.0
    for slot in range(1, int(count) + 1):
        result, duration = host.transfer(FROM=source, FROM_SLOT=slot, TO=target, TO_SLOT=slot, EFFECTOR=effector)
        total += duration
        print(f"{duration:8.3f} s  {source} {slot} to {target} {slot}: {result}")
    print(f"{total:8.3f} s  in all")
    print(host.status())
    host.disable()


if __name__ == "__main__":
    main(*sys.argv[1:])
