"""A submission that another program made of what `--inputs` wrote, and a specification that is frozen."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import torch

from needs import SHARED_MESHES
from normalgan.batch import Batch
from normalgan.benchmark import actions, command
from normalgan.benchmark.hints import hint_points
from normalgan.benchmark.measure import HintTests, measure
from normalgan.benchmark.methods import Method
from normalgan.benchmark.plan import read_plan
from normalgan.benchmark.specification import check_specification, specify
from normalgan.benchmark.submissions import read_submission, write_inputs
from normalgan.benchmark.table import ranked_error
from normalgan.data.datamodule import MeshDataModule
from normalgan.data.settings import EmbeddedAnimals, MeshReading, Split
from normalgan.errors import InputError
from normalgan.hints import NoHints, hints_at
from normalgan.rendering.lines import Silhouette, SuggestiveContours
from spheres import batch

CPU = torch.device("cpu")


@pytest.fixture
def given() -> Batch:
    return {**batch(size=32), "name": ["a/0", "b/1"]}


def theirs(inputs: Path, folder: Path, given: Batch) -> None:
    """Another program: paints what faces the viewer, and with hints the truth, in 8 bits."""
    for i, name in enumerate(given["name"]):
        paper = cv2.imread(str(inputs / "sketches" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        assert paper is not None
        np.testing.assert_allclose(1 - paper / 255, given["sketch"][i, 0].numpy(), atol=1 / 255)
        mask = given["mask"][i, 0].numpy()
        flat = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (32, 32, 3))
        for count, normals in (
            ("0", flat * mask[..., None]),
            ("5", given["normal"][i].permute(1, 2, 0).numpy()),
        ):
            path = folder / count / f"{name}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            colours = np.rint((normals + 1) / 2 * 255).astype(np.uint8)
            assert cv2.imwrite(str(path), colours[..., ::-1])
    (folder / "submission.json").write_text(json.dumps({"name": "theirs"}))


def test_the_inputs_are_the_tests_and_what_is_painted_of_them_is_measured(
    tmp_path: Path, given: Batch
) -> None:
    inputs, folder = tmp_path / "inputs", tmp_path / "theirs"
    write_inputs(inputs, given, [0, 5, 20], seed=3)
    points = json.loads((inputs / "hints" / "b" / "1.json").read_text())
    assert len(points) == 20
    where = hint_points(given["mask"], given["name"], 3, 5)[1, 0]
    assert {(p["y"], p["x"]) for p in points[:5]} == {tuple(at) for at in torch.nonzero(where).tolist()}
    told = hints_at(given["normal"], hint_points(given["mask"], given["name"], 3, 20))[1]
    for point in points:
        np.testing.assert_allclose(told[:3, point["y"], point["x"]].numpy(), point["normal"], atol=1e-5)

    theirs(inputs, folder, given)
    submission = read_submission(folder)
    assert (submission.name, submission.counts) == ("theirs", (0, 5))
    assert not submission.method().timed
    measured = measure(submission.method(), [given], HintTests([0, 5], seed=3), CPU)
    facing = given["normal"][:, 2:].clamp(-1, 1).acos().rad2deg()[given["mask"] > 0].mean()
    assert measured.figures["0"]["angular_mean"] == pytest.approx(float(facing), abs=0.1)
    assert measured.figures["5"]["angular_mean"] == pytest.approx(0, abs=0.25)  # of 8 bits
    assert measured.figures["0"]["mask_iou"] == 1


@pytest.mark.parametrize(("levels", "kind"), [(255, np.uint8), (65535, np.uint16)], ids=["8 bits", "16 bits"])
def test_grey_on_the_object_counts_as_transparent(
    tmp_path: Path, given: Batch, levels: int, kind: type[np.unsignedinteger[Any]]
) -> None:
    for name in given["name"]:
        path = tmp_path / "0" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        assert cv2.imwrite(str(path), np.full((32, 32, 3), (levels + 1) // 2, kind))
    (tmp_path / "submission.json").write_text(json.dumps({"name": "theirs"}))
    figures = measure(read_submission(tmp_path).method(), [given], HintTests([0]), CPU).figures["0"]
    assert figures["angular_mean"] is None  # no direction is given
    assert figures["mask_iou"] == figures["coverage"] == 0


def test_a_submission_that_cannot_be_used_is_answered_by_a_sentence(tmp_path: Path, given: Batch) -> None:
    inputs, folder = tmp_path / "inputs", tmp_path / "theirs"
    write_inputs(inputs, given, [5], seed=0)
    theirs(inputs, folder, given)
    assert cv2.imwrite(str(folder / "0" / "a" / "0.png"), np.zeros((8, 8, 3), np.uint8))
    with pytest.raises(InputError, match=r"has 32 × 32 pixels in colour"):
        measure(read_submission(folder).method(), [given], HintTests([0]), CPU)
    (folder / "0" / "a" / "0.png").unlink()
    with pytest.raises(InputError, match=r"there is no file .*0\.png"):
        measure(read_submission(folder).method(), [given], HintTests([0]), CPU)
    (folder / "0" / "a" / "0.exr").write_bytes(b"")
    with pytest.raises(
        InputError, match=r"there is no file .*0\.png, but 0\.exr; a submission has PNG files"
    ):
        measure(read_submission(folder).method(), [given], HintTests([0]), CPU)
    for written, said in (
        *(("{", "is not JSON"), ("[]", "has no name"), ("{}", "has no name")),
        *(('{"name": " "}', "has no name"), ('{"name": 3}', "has no name")),
    ):
        (folder / "submission.json").write_text(written)
        with pytest.raises(InputError, match=said):
            read_submission(folder)
    (folder / "submission.json").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        read_submission(folder)
    (folder / "submission.json").write_text(json.dumps({"name": "theirs"}))
    (folder / "0").rename(folder / "none")
    with pytest.raises(InputError, match="no folder 0"):
        read_submission(folder)


def data(**settings: Any) -> MeshDataModule:
    three = {"animals": EmbeddedAnimals(3), "split": Split((0.34, 0.33, 0.33)), "size": 32}
    return MeshDataModule(**{**three, **settings})


def test_a_specification_tells_what_the_figures_depend_on(tmp_path: Path) -> None:
    tests = HintTests([0, 15])
    found = specify(data(), tests)
    assert (
        specify(data(batch_size=3), HintTests([0, 50])) == found
    )  # neither changes a figure it is compared by
    for name, other in (
        ("meshes", specify(data(animals=EmbeddedAnimals(4), split=Split((0.5, 0.25, 0.25))), tests)),
        ("views", specify(data(test_views=7), tests)),
        ("views", specify(data(seed=5), tests)),
        ("hints", specify(data(), HintTests([0, 15], seed=1))),
        ("size", specify(data(size=64), tests)),
    ):
        assert other[name] != found[name]

    across = specify(data(lines=Silhouette()), tests, data())
    assert across["views"] != found["views"]
    assert across["training"] != specify(data(lines=Silhouette()), tests, data(seed=5))["training"]
    assert specify(data(), tests, data()) == found

    path = tmp_path / "v2.json"
    path.write_text(json.dumps({"version": "v2", "sizes": [found]}))
    check_specification(found, path)
    with pytest.raises(InputError, match=r"do not match v2 in .*: hints differ"):
        check_specification({**found, "hints": "x"}, path)
    with pytest.raises(InputError, match=r"no benchmark at 64 pixels; use data.size 32"):
        check_specification({**found, "size": 64}, path)
    for written, said in (
        ("{", "is not JSON"),
        ("{}", "no version or sizes"),
        ('{"version": "v2", "sizes": []}', "no version or sizes"),
        ('{"version": "v2", "sizes": [1]}', "no"),
    ):
        path.write_text(written)
        with pytest.raises(InputError, match=said):
            check_specification(found, path)
    with pytest.raises(InputError, match="cannot be read"):
        check_specification(found, tmp_path / "gone.json")


def test_the_frozen_specification_holds_for_its_own_sizes_alone() -> None:
    path = Path(__file__).parents[2] / "configs" / "benchmark" / "v3.json"
    frozen = json.loads(path.read_text(encoding="utf-8"))
    tracks = {one["track"] for one in frozen["sizes"]}
    assert tracks == {"fourlegs", "animals", "people", "props", "rigs", "lines"}
    assert {one["size"] for one in frozen["sizes"] if one["track"] == "fourlegs"} == {64, 128, 256}
    for one in frozen["sizes"]:
        assert check_specification({k: v for k, v in one.items() if k != "track"}, path) == one["track"]
        assert ("training" in one) == (one["track"] == "lines")
    (people,) = (one for one in frozen["sizes"] if (one["track"], one["size"]) == ("people", 256))
    with pytest.raises(InputError, match=r"v3, the track people in .*: views differ"):
        check_specification({**people, "views": "x"}, path)
    # Hints are given by a rule that no plan changes but for the seed, which is 0 in ours.
    assert {one["hints"] for one in frozen["sizes"]} == {specify(data(), HintTests([0]))["hints"]}
    with pytest.raises(InputError, match=r"v3, the track \w+ in .*: meshes and views differ"):
        check_specification({**specify(data(), HintTests([0])), "size": 128}, path)


@pytest.mark.parametrize(
    ("track", "settings"),
    [
        ("people", {"meshes": "people/*.ply"}),
        ("props", {"meshes": "objects/*.glb", "reading": {"crease_angle": 40.0}}),
    ],
)
def test_tracks_are_those_of_the_meshes(track: str, settings: dict[str, Any]) -> None:
    """What was frozen is what the plan of the track measures on."""
    meshes = Path(__file__).parents[2] / ".." / "shared" / "meshes"
    if not meshes.is_dir():
        pytest.skip(SHARED_MESHES.reason(f"{meshes} is not there"))
    folder = Path(__file__).parents[2] / "configs" / "benchmark"
    frozen = json.loads((folder / "v3.json").read_text(encoding="utf-8"))["sizes"]
    plan = read_plan(folder / f"{track}.yaml").data
    assert plan["meshes"].endswith(settings["meshes"])
    assert plan.get("reading", {}) == settings.get("reading", {})
    assert plan["split"] == {"fractions": [0.9, 0.04, 0.06]}
    reading, split = MeshReading(**plan.get("reading", {})), Split((0.9, 0.04, 0.06))
    settings = {"meshes": str(meshes / settings["meshes"]), "reading": reading, "split": split}
    lines = SuggestiveContours(**plan["lines"]["init_args"])
    (wanted,) = (one for one in frozen if (one["track"], one["size"]) == (track, 256))
    found = specify(MeshDataModule(**settings, lines=lines, test_views=plan["test_views"]), HintTests([0]))
    assert {**found, "track": track} == wanted


def test_the_packages_own_specification_is_found_where_there_is_no_clone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[bool] = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(actions, "check", lambda plan, scale, path: found.append(path.is_file()))
    monkeypatch.setattr(actions, "write_test_inputs", lambda plan, scale, folder: 0)
    named = ["--config", "configs/benchmark/people.yaml", "--spec", "configs/benchmark/v3.json"]
    assert command.run([*named, "--inputs", "inputs"]) == 0
    assert found == [True]


@pytest.mark.parametrize(
    "two", [("--inputs", "--score"), ("--score", "--evaluate"), ("--evaluate", "--inputs")]
)
def test_two_modes_at_once_are_refused(two: tuple[str, str]) -> None:
    both = [text for name in two for text in (name, "there")]
    with pytest.raises(InputError, match="cannot be combined; run a command for each"):
        command.run(["--config", "configs/benchmark/people.yaml", *both])


def written(folder: Path, given: Batch, maps: torch.Tensor, opaque: torch.Tensor | None) -> Path:
    """Write maps (N, 3, H, W) in 16 bits, with the opacity (N, H, W) if there is one."""
    for i, name in enumerate(given["name"]):
        path = folder / "0" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        colours = np.rint((maps[i].permute(1, 2, 0).numpy()[..., ::-1] + 1) / 2 * 65535).astype(np.uint16)
        if opaque is not None:
            colours = np.dstack([colours, np.where(opaque[i].numpy(), 65535, 0).astype(np.uint16)])
        assert cv2.imwrite(str(path), colours)
    (folder / "submission.json").write_text(json.dumps({"name": "theirs"}))
    return folder


@pytest.mark.parametrize("with_opacity", [True, False])
def test_a_network_has_the_same_figures_as_a_row_and_as_a_submission(
    tmp_path: Path, given: Batch, with_opacity: bool
) -> None:
    # A weak network: turned normals, of which half are too short to be an object, and some background.
    maps = (given["normal"] + torch.tensor([0.4, 0.2, 0.0]).view(1, 3, 1, 1)) * 0.55
    maps[:, :, :, :16] *= 0.5
    opaque = maps.square().sum(1).sqrt() > 0.5
    row = Method(lambda batch, hints: maps, NoHints(), timed=False)
    theirs = read_submission(written(tmp_path, given, maps, opaque if with_opacity else None)).method()
    one, other = (measure(m, [given], HintTests([0]), CPU).figures["0"] for m in (row, theirs))
    for name in ("angular_mean", "angular_median", "coverage", "mask_iou"):
        assert other[name] == pytest.approx(one[name], abs=0.2), name
    assert 0 < float(one["coverage"] or 0) < 0.9


@pytest.mark.parametrize("share", [1.0, 0.4], ids=["exact", "weak"])
def test_a_submission_whose_green_points_down_is_refused(tmp_path: Path, given: Batch, share: float) -> None:
    noise = torch.randn(given["normal"].shape, generator=torch.Generator().manual_seed(0))
    maps = torch.nn.functional.normalize(share * given["normal"] + (1 - share) * noise, dim=1)
    right = written(tmp_path / "right", given, maps, given["mask"][:, 0] > 0.5)
    measure(read_submission(right).method(), [given], HintTests([0]), CPU)
    flipped = maps * torch.tensor([1.0, -1.0, 1.0]).view(1, 3, 1, 1)
    folder = written(tmp_path / "flipped", given, flipped, given["mask"][:, 0] > 0.5)
    with pytest.raises(InputError, match="seem to have a flipped green channel"):
        measure(read_submission(folder).method(), [given], HintTests([0]), CPU)


@pytest.mark.parametrize("share", [1.0, 0.4], ids=["exact", "weak"])
@pytest.mark.parametrize(
    ("order", "sign", "said"),
    [
        ([0, 1, 2], [-1, 1, 1], "seem to have a flipped red channel: y agrees .* and x contradicts"),
        ([0, 1, 2], [-1, -1, 1], "seem to have flipped red and green channels: x and y contradict"),
        ([0, 1, 2], [1, 1, -1], r"point away from the viewer: z is -0\.\d\d on average"),
        (
            [2, 1, 0],
            [1, 1, 1],
            "seem to have red and blue exchanged: each agrees with the true normals of the",
        ),
        ([1, 0, 2], [1, 1, 1], "seem to have red and green exchanged"),
        ([0, 2, 1], [1, 1, 1], "seem to have green and blue exchanged"),
    ],
)
def test_a_submission_with_flipped_or_exchanged_channels_is_refused(
    tmp_path: Path, given: Batch, share: float, order: list[int], sign: list[float], said: str
) -> None:
    noise = torch.randn(given["normal"].shape, generator=torch.Generator().manual_seed(0))
    maps = torch.nn.functional.normalize(share * given["normal"] + (1 - share) * noise, dim=1)
    wrong = maps[:, order] * torch.tensor(sign).view(1, 3, 1, 1)
    folder = written(tmp_path, given, wrong, given["mask"][:, 0] > 0.5)
    with pytest.raises(InputError, match=said):
        measure(read_submission(folder).method(), [given], HintTests([0]), CPU)


def test_a_submission_without_background_is_warned_about(tmp_path: Path, given: Batch) -> None:
    flat = torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
    maps = torch.where(given["mask"] > 0.5, given["normal"], flat)
    folder = written(tmp_path, given, maps, None)
    with pytest.warns(
        UserWarning, match=r"mark all pixels as object; the background needs the opacity 0"
    ) as told:
        measure(read_submission(folder).method(), [given, given], HintTests([0]), CPU)
    assert len(told) == 1


def test_leaving_out_hard_pixels_lowers_the_rank() -> None:
    assert ranked_error(10, 0.8) > ranked_error(20, 1.0)
