"""By folder: a scheduler that gives all tests of one folder to one worker."""

from xdist.scheduler import LoadScopeScheduling


class ByFolder(LoadScopeScheduling):
    """All tests of one folder go to one worker, so that their shared objects are made once."""

    def _split_scope(self, nodeid: str) -> str:
        return "/".join(nodeid.partition("::")[0].split("/")[:2])
