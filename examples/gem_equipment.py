"""GEM equipment in front of a simulated controller: a fab host transfers wafers by remote commands (SEMI E5, E30, E37).

    pip install secsgem
    jointplay cell serve --speed 100
    python3 gem_equipment.py 127.0.0.1:7000 5000

The remote command TRANSFER (FROM, FROM_SLOT, TO, TO_SLOT, EFFECTOR) is acknowledged with *finish later*.
The collection event 1000 follows when the wafer is in its slot, or when the controller has refused a command;
its data values state which: 30 RESULT (text) and 31 DURATION (s).
The status variable 10 is the answer of the controller to STATUS.
"""

import contextlib
import sys
import threading

import secsgem.common
import secsgem.gem
import secsgem.hsms
import secsgem.secs
from controller_host import Controller

STATUS, RESULT, DURATION, TRANSFER_FINISHED = 10, 30, 31, 1000


class Equipment(secsgem.gem.GemEquipmentHandler):
    """Equipment with one robot, whose controller speaks the neutral language."""

    def __init__(self, controller, port):
        settings = secsgem.hsms.HsmsSettings(
            address="127.0.0.1",
            port=port,
            connect_mode=secsgem.hsms.HsmsConnectMode.PASSIVE,
            device_type=secsgem.common.DeviceType.EQUIPMENT,
        )
        super().__init__(settings)
        self.controller = controller
        # The controller executes one command at a time.
        self.robot = threading.Lock()
        self.result, self.duration = "", 0.0
        text, number = secsgem.secs.variables.String, secsgem.secs.variables.F8
        self.status_variables[STATUS] = secsgem.gem.StatusVariable(STATUS, "robot", "", text)
        self.data_values[RESULT] = secsgem.gem.DataValue(RESULT, "RESULT", text)
        self.data_values[DURATION] = secsgem.gem.DataValue(DURATION, "DURATION", number)
        self.collection_events[TRANSFER_FINISHED] = secsgem.gem.CollectionEvent(
            TRANSFER_FINISHED, "transfer finished", [RESULT, DURATION]
        )
        parameters = ["FROM", "FROM_SLOT", "TO", "TO_SLOT", "EFFECTOR"]
        self.remote_commands["TRANSFER"] = secsgem.gem.RemoteCommand("TRANSFER", "transfer a wafer", parameters, TRANSFER_FINISHED)
        # Callbacks are attributes: secsgem 0.3 does not find methods of these names.
        self.callbacks.rcmd_TRANSFER = self.transfer

    def transfer(self, **values):
        """Moves one wafer; the result is that of the last command."""
        with self.robot:
            self.result, self.duration = "COMPLETED", 0.0
            try:
                pick = f"GET {values['FROM']} {values['FROM_SLOT']} {values['EFFECTOR']}"
                place = f"PUT {values['TO']} {values['TO_SLOT']} {values['EFFECTOR']}"
                for command in (pick, place):
                    self.duration += self.controller.execute(command)
            except KeyError as error:
                self.result = f"REFUSED without parameter {error.args[0]}"
            except (RuntimeError, OSError, ValueError) as error:
                self.result = str(error)

    def on_sv_value_request(self, svid, status_variable):
        with self.robot:
            return status_variable.value_type(self.controller.ask("STATUS"))

    def on_dv_value_request(self, dvid, data_value):
        return data_value.value_type(self.result if data_value.dvid == RESULT else self.duration)


def main(address, port):
    controller = Controller(address)
    equipment = Equipment(controller, int(port))
    equipment.enable()
    print(f"equipment at 127.0.0.1:{port}: {controller.welcome}", flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        threading.Event().wait()
    equipment.disable()


if __name__ == "__main__":
    main(*sys.argv[1:])
