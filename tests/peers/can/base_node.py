"""Python's canopen drives the simulated CiA 402 drive: python base_node.py SERIAL_PORT

The other end of the port is an slcan adapter with the drive as node 1. Prints one line for each claim
that holds and "done" at the end; a claim that does not hold is an exception and a non-zero exit code.
"""

import pathlib
import sys
import threading
import time

import canopen
from canopen.profiles.p402 import BaseNode402

NODE = 1
MASTER = 0x7F
EDS = str(pathlib.Path(__file__).with_name("drive.eds"))


def claim(what, holds):
    if not holds:
        raise AssertionError(what)
    print("holds:", what, flush=True)


def until(what, condition, seconds=3.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"not in {seconds} s: {what}")
        time.sleep(0.005)
    print("holds:", what, flush=True)


def abort_code(action):
    try:
        action()
    except canopen.SdoAbortedError as error:
        return error.code
    return None


def identity(node):
    claim("device type is a servo drive of profile 402", node.sdo[0x1000].raw == 0x00020192)
    claim("the name comes in segments", node.sdo[0x1008].raw == "simulated drive")
    claim("serial number is the node-ID", node.sdo[0x1018][4].raw == NODE)
    claim("mode 10 is supported", node.sdo[0x6502].raw & (1 << 9))


def refusals(node):
    claim("no such object", abort_code(lambda: node.sdo.upload(0x2FFF, 0)) == 0x06020000)
    claim("no such sub-index", abort_code(lambda: node.sdo.upload(0x1018, 9)) == 0x06090011)
    claim("read only", abort_code(lambda: node.sdo.download(0x6041, 0, b"\0\0")) == 0x06010002)
    claim("too long", abort_code(lambda: node.sdo.download(0x6040, 0, b"\0\0\0\0")) == 0x06070012)
    claim("no such mode", abort_code(lambda: node.sdo.download(0x6060, 0, b"\x08")) == 0x06090030)


def map_pdos(node):
    node.tpdo.read()
    node.rpdo.read()
    out = node.tpdo[1]
    out.clear()
    for index in (0x6041, 0x6064, 0x6077):
        out.add_variable(index)
    out.trans_type = 1
    out.enabled = True
    command = node.rpdo[1]
    command.clear()
    command.add_variable(0x6040)
    command.add_variable(0x6071)
    command.trans_type = 1
    command.event_timer = 0
    command.enabled = True
    node.tpdo.save()
    node.rpdo.save()
    claim("COB-ID of TPDO 1", out.cob_id == 0x181)
    claim("COB-ID of RPDO 1", command.cob_id == 0x201)


def drive(node):
    node.setup_402_state_machine()
    # Synchronous receive PDOs are sent in a cycle, not with each change.
    node.rpdo[1].start(0.01)
    node.state = "OPERATION ENABLED"
    claim("operation enabled by BaseNode402", node.state == "OPERATION ENABLED")
    node.sdo[0x6060].raw = 10
    until("mode display is 10", lambda: node.sdo[0x6061].raw == 10)
    start = node.sdo[0x6064].raw
    node.rpdo[1][0x6071].raw = 200
    until("actual torque is the target", lambda: node.tpdo[1][0x6077].raw == 200)
    until("the rotor turns forward", lambda: node.tpdo[1][0x6064].raw > start + 100)
    node.sdo[0x6072].raw = 500
    node.rpdo[1][0x6071].raw = -900
    until("torque is limited by 0x6072", lambda: node.tpdo[1][0x6077].raw == -500)
    until("internal limit active", lambda: node.tpdo[1][0x6041].raw & (1 << 11))
    node.state = "READY TO SWITCH ON"
    until("no torque when shut down", lambda: node.tpdo[1][0x6077].raw == 0)
    node.rpdo[1][0x6071].raw = 0


def lose_heartbeat(network, node):
    """The drive faults when the master's heartbeat stops, and a reset brings it back."""
    node.sdo[0x1016][1].raw = (MASTER << 16) | 150
    task = network.send_periodic(0x700 + MASTER, b"\x05", 0.03)
    time.sleep(0.2)
    node.state = "OPERATION ENABLED"
    claim("operation enabled again", node.state == "OPERATION ENABLED")
    task.stop()
    until("fault after the heartbeat", lambda: node.state == "FAULT")
    until("emergency 0x8130", lambda: any(error.code == 0x8130 for error in node.emcy.log))
    claim("error code object", node.sdo[0x603F].raw == 0x8130)
    node.sdo[0x1016][1].raw = 0
    node.reset_from_fault()
    claim("enabled after the reset", node.state == "OPERATION ENABLED")
    node.state = "SWITCH ON DISABLED"
    claim("switched off", node.state == "SWITCH ON DISABLED")
    node.rpdo[1].stop()


def main(port):
    network = canopen.Network()
    network.connect(interface="slcan", channel=port, bitrate=1000000, sleep_after_open=0.05)
    node = BaseNode402(NODE, EDS)
    network.add_node(node)
    # The boot-up message may come before the answer to the reset is waited for.
    threading.Timer(0.1, lambda: network.send_message(0, [129, NODE])).start()
    node.nmt.wait_for_bootup(5)
    claim("boot-up message after a reset", True)
    identity(node)
    refusals(node)
    node.sdo[0x1017].raw = 50
    map_pdos(node)
    network.sync.start(0.01)
    node.nmt.state = "OPERATIONAL"
    node.nmt.wait_for_heartbeat(2)
    until("heartbeats say operational", lambda: node.nmt.state == "OPERATIONAL")
    drive(node)
    lose_heartbeat(network, node)
    network.sync.stop()
    network.disconnect()
    print("done", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
