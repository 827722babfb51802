"""pleatd on a free port of the loopback interface, for tests in Python."""

import signal
import subprocess


class ServerProcess:
    """Runs until `stop`, over a data folder that a later one may go on with."""

    def __init__(self, pleatd, data_folder, listen="127.0.0.1:0"):
        self._process = subprocess.Popen(
            [pleatd, "--listen", listen, "--data-dir", data_folder, "--job-priority", "normal"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self._process.stdout.readline()
        if not line.startswith("listening on "):
            self._process.kill()
            raise RuntimeError(f"{pleatd} does not come up: {line}")
        self.address = line.split()[2]

    def stop(self):
        self._process.send_signal(signal.SIGTERM)
        self._process.wait(30)
        self._process.stdout.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._process.poll() is None:
            self.stop()
