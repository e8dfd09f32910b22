"""One broker for the tests of a module."""

from collections.abc import Iterator

import pytest

from tests.mqtt import Broker, mosquitto


@pytest.fixture(scope="module")
def broker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Broker]:
    with mosquitto(tmp_path_factory.mktemp("mqtt")) as found:
        yield found
