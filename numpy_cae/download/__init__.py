"""Motion databases from where they are published: the standard library alone, and no half files."""

from numpy_cae.download.cmu import CmuSite, Tally, download_cmu
from numpy_cae.download.fetch import DownloadError, fetch

__all__ = ["CmuSite", "DownloadError", "Tally", "download_cmu", "fetch"]
