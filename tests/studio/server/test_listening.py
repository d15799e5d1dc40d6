"""Where the studio listens."""

import pytest

from normalgan.errors import InputError
from normalgan.studio.server.serving import listen


def test_it_is_reached_from_this_machine_only_unless_another_address_is_given() -> None:
    with listen(0) as listening:
        assert listening.getsockname()[0] == "127.0.0.1"
    with listen(0, "0.0.0.0") as listening:
        assert listening.getsockname()[0] == "0.0.0.0"


@pytest.mark.parametrize("address", ["localhost", "::1", "1.2.3", ""])
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(InputError, match=r"is not an IPv4 address; use 127\.0\.0\.1, or 0\.0\.0\.0"):
        listen(0, address)
