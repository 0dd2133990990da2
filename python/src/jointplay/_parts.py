"""Folders of the parts of a study, local or on a file system of fsspec."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ._base import write_whole, writing
from ._errors import InputError, MissingPartsError

if TYPE_CHECKING:
    from ._jointplay import Plan

DIRECT = frozenset(
    {"memory", "s3", "s3a", "gs", "gcs", "abfs", "abfss", "az", "adl", "oci", "oss", "r2", "asynclocal"}
)
"""File systems of fsspec on which a file appears only when it is complete."""


class Store(Protocol):
    """A folder of files."""

    def names(self) -> set[str]:
        """Names of the files; empty if the folder does not exist."""
        ...

    def exists(self, name: str) -> bool:
        """Whether a file exists."""
        ...

    def read(self, name: str) -> bytes:
        """Contents of a file; raises ``FileNotFoundError`` if it does not exist."""
        ...

    def write(self, name: str, contents: bytes) -> None:
        """Writes a file completely or not at all, and creates the folder if necessary."""
        ...


class LocalStore:
    """A folder of the local file system, which machines may share."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def names(self) -> set[str]:
        try:
            return set(os.listdir(self._folder))
        except FileNotFoundError:
            return set()

    def exists(self, name: str) -> bool:
        return (self._folder / name).exists()

    def read(self, name: str) -> bytes:
        return (self._folder / name).read_bytes()

    def write(self, name: str, contents: bytes) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)
        write_whole(self._folder / name, contents)


class RemoteStore:
    """A folder of a file system of fsspec."""

    def __init__(self, filesystem: Any, folder: str) -> None:
        self._filesystem = filesystem
        self._folder = folder.rstrip("/")
        protocol = filesystem.protocol
        self._direct = bool(DIRECT & set((protocol,) if isinstance(protocol, str) else protocol))

    def names(self) -> set[str]:
        # Other processes write into the same folder.
        self._filesystem.invalidate_cache()
        try:
            found: Iterable[str] = self._filesystem.ls(self._folder, detail=False)
        except FileNotFoundError:
            return set()
        return {path.rstrip("/").rpartition("/")[2] for path in found}

    def exists(self, name: str) -> bool:
        self._filesystem.invalidate_cache()
        return bool(self._filesystem.exists(f"{self._folder}/{name}"))

    def read(self, name: str) -> bytes:
        contents: bytes = self._filesystem.cat_file(f"{self._folder}/{name}")
        return contents

    def write(self, name: str, contents: bytes) -> None:
        path = f"{self._folder}/{name}"
        if self._direct:
            self._filesystem.pipe_file(path, contents)
            return
        partial = f"{self._folder}/.jointplay-partial-{uuid.uuid4().hex}"
        self._filesystem.makedirs(self._folder, exist_ok=True)
        self._filesystem.pipe_file(partial, contents)
        self._filesystem.mv(partial, path)


def _store(location: str, filesystem: Any, options: Mapping[str, Any]) -> Store:
    if filesystem is None and "://" not in location:
        return LocalStore(Path(location))
    try:
        # fsspec has no type annotations.
        fsspec: Any = import_module("fsspec")
        arrow: Any = import_module("fsspec.implementations.arrow")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError("folders at a URL need fsspec: pip install 'jointplay[remote]'", name="fsspec") from error
    if filesystem is None:
        filesystem, location = fsspec.core.url_to_fs(location, **options)
    elif not isinstance(filesystem, fsspec.AbstractFileSystem):
        filesystem = arrow.ArrowFSWrapper(filesystem)
    return RemoteStore(filesystem, location)


class Parts:
    """Folder of the parts of a study, one part for each chunk; ``Plan.parts`` creates it.

    ``write`` computes one part, on any machine and in any order: engines such as Dask, Ray or ``concurrent.futures`` map it over ``missing()``.
    The object pickles with its plan; a folder contains the parts of one study only.
    """

    def __init__(
        self,
        *,
        plan: Plan,
        location: str | os.PathLike[str],
        filesystem: Any = None,
        storage_options: Mapping[str, Any] | None = None,
        format: str = "parquet",
        threads: int = 1,
    ) -> None:
        if filesystem is None and storage_options and "://" not in os.fspath(location):
            raise InputError("storage_options are for the URL of a folder")
        self._plan = plan
        self._location = os.fspath(location)
        self._filesystem = filesystem
        self._options = dict(storage_options or {})
        self._format = format
        self._threads = threads
        self._opened: Store | None = None
        self._checked = False

    @property
    def plan(self) -> Plan:
        """The plan of the study."""
        return self._plan

    @property
    def location(self) -> str:
        """Path or URL of the folder."""
        return self._location

    @property
    def format(self) -> str:
        """Format of the tables, ``'parquet'`` or ``'csv'``."""
        return self._format

    @property
    def _store(self) -> Store:
        if self._opened is None:
            self._opened = _store(self._location, self._filesystem, self._options)
        return self._opened

    def _done(self) -> set[int]:
        """Numbers of the finished parts of the folder."""
        self._check(create=False)
        return self._plan._done(self._store.names(), self._format)

    def _check(self, *, create: bool) -> None:
        """Checks once that the folder contains this study, and writes the description of a new folder."""
        if self._checked:
            return
        name, contents = self._plan._manifest(self._format)
        try:
            found = self._store.read(name)
        except FileNotFoundError:
            if not create:
                return
            self._store.write(name, contents)
            # Another task may have written it at the same time.
            found = self._store.read(name)
        self._plan._check_manifest(found, self._format)
        self._checked = True

    def write(self, part: int) -> int:
        """Computes a part, and writes its table and its record; a finished part is not computed again.

        Parameters
        ----------
        part : int
            Number of the part, from 0.

        Returns
        -------
        int
            The number of the part.

        Raises
        ------
        PartsError
            If the folder contains the parts of another study.
        """
        self._check(create=True)
        table_name, record_name = self._plan._part_names(part, self._format)
        if self._store.exists(record_name) and self._store.exists(table_name):
            return part
        table, record = self._plan._part_files(part, self._format, self._threads)
        # A part is finished once it has a record.
        self._store.write(table_name, table)
        self._store.write(record_name, record)
        return part

    def missing(self) -> list[int]:
        """Numbers of the parts that are not finished."""
        done = self._done()
        return [part for part in range(self._plan.chunks) if part not in done]

    def status(self) -> dict[str, Any]:
        """Numbers of finished and missing parts, as ``jointplay study --status`` reports them."""
        return self._plan._status(self._done())

    def summary(self, *, threads: int | None = None) -> dict[str, Any]:
        """The summary of all samples, bit by bit equal to that of ``jointplay study`` for the whole study.

        Parameters
        ----------
        threads : int, optional
            Number of threads for the percentiles; by default one per core.

        Raises
        ------
        MissingPartsError
            If parts are missing.
        """
        self._require_all()
        names = (self._plan._part_names(part, self._format)[1] for part in range(self._plan.chunks))
        return self._plan._summary([self._store.read(name) for name in names], threads)

    def gather(self, path: str | os.PathLike[str]) -> None:
        """Writes the table of all parts to a local file, with the same bytes as a run on one machine.

        The file is written completely or not at all; an existing file is replaced.

        Raises
        ------
        MissingPartsError
            If parts are missing.
        PartsError
            If a part has changed since it was written.
        """
        path = Path(path)
        if path.suffix != f".{self._format}":
            raise InputError(f"the parts are {self._format} tables: the name of the file has to end in .{self._format}")
        self._require_all()
        gathering = self._plan._gathering(self._format)
        with writing(path) as file:
            file.write(gathering.head())
            for _ in range(self._plan.chunks):
                table, record = gathering.next()
                file.write(gathering.add(self._store.read(record), self._store.read(table)))
            file.write(gathering.finish())

    def _require_all(self) -> None:
        missing, parts = self.missing(), self._plan.chunks
        if missing:
            raise MissingPartsError(
                f"{len(missing)} of {parts} parts are missing, the first is part {missing[0]}",
                missing=len(missing),
                parts=parts,
                first=missing[0],
            )

    def __getstate__(self) -> dict[str, Any]:
        # The receiving process opens its own connection.
        return {**self.__dict__, "_opened": None, "_checked": False}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Parts):
            return NotImplemented
        return (self._plan, self._location, self._format) == (other._plan, other._location, other._format)

    def __hash__(self) -> int:
        return hash((self._plan, self._location, self._format))

    def __repr__(self) -> str:
        return f"Parts({self._plan!r}, {self._location!r})"
