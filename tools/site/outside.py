"""Hook of the site: makes pages of files outside docs/ that its pages link to, and corrects the links."""

import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"(?<=\])\((?!https?://|mailto:|#)([^)\s#]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"^(```.*?^```$)", re.M | re.S)
CONFIGURATIONS = "reference/configurations.md"
PLACES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "configs": CONFIGURATIONS,
}
"""The place on the site of repository files that do not keep their own path."""
SOURCES: dict[str, str] = {}
"""The repository file behind each added page."""
LANGUAGES = {".toml": "toml", ".py": "python", ".yaml": "yaml", ".yml": "yaml", ".sh": "sh", ".json": "json"}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add pages for files outside docs/, and for the files that these link to."""
    waiting = [ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]
    for file in files.documentation_pages():
        waiting += outside_links(Path("docs") / file.src_uri, file.content_string)
    done: set[Path] = set()
    while waiting:
        path = waiting.pop()
        place = site_path(path.relative_to(ROOT).as_posix())
        if path in done or files.get_file_from_path(place):
            continue
        done.add(path)
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".md":
            waiting += outside_links(path.relative_to(ROOT), text)
        else:
            text = f"# {path.name}\n\n```{LANGUAGES.get(path.suffix, 'text')}\n{text.rstrip()}\n```\n"
        SOURCES[place] = path.relative_to(ROOT).as_posix()
        files.append(File.generated(config, place, content=text))
    files.append(File.generated(config, CONFIGURATIONS, content=configurations()))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Return a page with its links into the repository redirected to pages of the site."""
    uri = page.file.src_uri
    if uri not in SOURCES and page.file.generated_by is not None:
        return markdown  # another hook made it for this place
    source = SOURCES.get(uri, f"docs/{uri}")

    def moved(found: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(source), found[1]))
        if target.startswith("src/normalgan/") and target.endswith(".py"):
            return f"[{target.removeprefix('src/').removesuffix('.py').replace('/', '.')}]"
        anchor = f"#{slug(target)}" if target.startswith("configs/") else found[2] or ""
        return f"({posixpath.relpath(site_path(target), posixpath.dirname(uri) or '.')}{anchor})"

    return "".join(
        part if part.startswith("```") else LINK.sub(moved, part) for part in FENCE.split(markdown)
    )


def outside_links(source: Path, text: str) -> list[Path]:
    """Return the files outside docs/ and src/ that a page of the repository links to."""
    found = []
    for match in LINK.finditer(FENCE.sub("", text)):
        path = Path(posixpath.normpath((source.parent / match[1]).as_posix()))
        if path.parts[0] in {"docs", "src", "configs", "notebooks"} or path.as_posix() in PLACES:
            continue
        if not (ROOT / path).exists():
            raise PluginError(f"{source} links to {match[1]}, which does not exist")
        if (ROOT / path).is_file():
            found.append(ROOT / path)
        elif (ROOT / path / "README.md").is_file():
            found.append(ROOT / path / "README.md")
        else:
            raise PluginError(f"{source} links to the folder {path}, which has no README.md to show")
    return found


def site_path(path: str) -> str:
    """Return the path on the site of a repository file."""
    if path in PLACES:
        return PLACES[path]
    if path.startswith("configs/"):
        return CONFIGURATIONS
    if path.endswith(".ipynb"):
        return path.removesuffix(".ipynb") + ".md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    if (ROOT / path).is_dir():
        path = f"{path}/README.md"
    return f"files/{path}" if path.endswith(".md") else f"files/{path}.md"


def configurations() -> str:
    """Return the page that shows all configurations."""
    parts = [
        "# Configurations",
        "The configurations of the package, whole, and the splits and orientations that they name. What each "
        "is for: [training](../training.md#configurations).",
    ]
    for path in sorted(p for p in (ROOT / "configs").rglob("*") if p.suffix in {".yaml", ".json"}):
        name = path.relative_to(ROOT).as_posix()
        text = path.read_text(encoding="utf-8").rstrip()
        parts.append(f"## {name} {{ #{slug(name)} }}\n\n```{LANGUAGES[path.suffix]}\n{text}\n```")
    return "\n\n".join(parts) + "\n"


def slug(name: str) -> str:
    """Return the anchor of a configuration; for a folder, that of its first file, settings before splits."""
    if (ROOT / name).is_dir():
        shown = [path for path in (ROOT / name).rglob("*") if path.suffix in LANGUAGES]
        name = min(shown, key=lambda path: (path.suffix != ".yaml", path)).relative_to(ROOT).as_posix()
    return re.sub(r"[^a-z0-9]+", "-", name.lower())
