"""In EyeLink text, numbers outside a recording block are no samples, also where the block has no END."""

from collections.abc import Callable

import pytest

from higvf_interfaces.formats.reading import read_gaze

START = "START\t{0} \tRIGHT\tSAMPLES\tEVENTS\nSAMPLES\tGAZE\tRIGHT\tRATE\t1000.00\tTRACKING\tCR\n"
COEFFICIENTS = "     -0  95.801 -7.7092  0.054973  0.022975\n   400.1 -3.604  107.47 -0.12785 -0.13718\n"
BANNER = ">>>>>>> CALIBRATION (HV5,P-CR) FOR RIGHT: <<<<<<<<<\n"
MESSAGE = "MSG\t889600 !CAL Cal coeff:(X=a+bx+cy+dxx+eyy,Y=f+gx+goaly+ixx+jyy)\n"


def block(start: int) -> str:
    return START.format(start) + "".join(f"{start + k}\t  916.5\t  575.5\t  655.0\t...\n" for k in range(20))


@pytest.mark.parametrize("said", [BANNER + MESSAGE, BANNER, MESSAGE], ids=["both", "banner", "message"])
def test_a_calibration_ends_a_block_without_end(write: Callable[..., str], said: str) -> None:
    head = "** CONVERTED FROM x.edf\n**\nMSG\t814482 DISPLAY_COORDS 0 0 1919 1079\n"
    gaze = read_gaze(
        write(head + block(889500) + said + COEFFICIENTS + block(889700) + "END\t889720 \tSAMPLES\tEVENTS\n")
    )
    assert len(gaze.time) == 40
    assert gaze.time[-1] == pytest.approx(0.219)
    assert gaze.notes == ()
