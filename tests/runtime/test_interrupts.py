"""Ctrl-C comes between two steps, never inside one."""

import signal
import threading

import pytest

from higvf_console.runtime.interrupts import held_back

pytestmark = pytest.mark.usefixtures("interruptible")


def test_a_first_interrupt_waits_until_it_is_asked_for() -> None:
    steps = 0
    with pytest.raises(KeyboardInterrupt), held_back() as give_interrupt:
        for _ in range(3):
            give_interrupt()
            signal.raise_signal(signal.SIGINT)
            steps += 1
    assert steps == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_second_interrupt_does_not_wait_for_a_step_that_hangs() -> None:
    with pytest.raises(KeyboardInterrupt), held_back():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        pytest.fail("the second one was kept too")


def test_an_interrupt_in_the_last_step_is_not_lost() -> None:
    steps = 0
    with pytest.raises(KeyboardInterrupt), held_back():
        signal.raise_signal(signal.SIGINT)
        steps += 1
    assert steps == 1


def test_another_thread_leaves_interrupts_as_they_are() -> None:
    seen: list[object] = []

    def work() -> None:
        with held_back() as give_interrupt:
            give_interrupt()
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [signal.default_int_handler]


def test_interrupts_that_are_ignored_stay_ignored() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with held_back() as give_interrupt:
        signal.raise_signal(signal.SIGINT)
        give_interrupt()
