"""What the processes of a cluster are given to do in tests; they import this, and little else."""

import os
import signal
import time


def square(number):
    return number * number, os.getpid(), os.getppid()


def fragile(number):
    if number == 1:
        os.abort()
    if number == 3:
        time.sleep(600.0)
    return number


def full(number):
    raise OSError(28, "No space left on device", str(number))


def begun(task):
    folder, number = task
    (folder / f"{number}_{os.getpid()}").touch()
    if number:
        time.sleep(600.0)
    return number


def poisonous(number):
    """Ends the worker, again and again."""
    if number == 1:
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600.0)
    return number
