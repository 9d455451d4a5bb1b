"""Downloads of public motion capture data, for which the extra `download` installs pooch."""

from numpy_cae.download.cmu import DownloadError, download_cmu

__all__ = ["DownloadError", "download_cmu"]
