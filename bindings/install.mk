# Part of the Makefile: installation and distribution. Run `make` first, then:
#
# make install      library (SONAME and symlinks, static too), headers, pkg-config and CMake files, licences; the debug symbols
#                   of the shared library go into .debug/ beside it, where gdb looks for them
# make uninstall    removes the installed files
# make dist         packs the last commit into out/luxfer-VERSION.tar.gz
#
# PREFIX=/usr/local   folder of the installation; its subfolders LIBDIR (such as $(PREFIX)/lib/x86_64-linux-gnu),
#                     INCLUDEDIR and DOCDIR can be set too
# DESTDIR=            folder in which the installation is staged, for packages
# DEBUG=split         with DEBUG=keep, the libraries are installed as built, with their debug symbols: for packagers
#                     whose tools split them

PREFIX     ?= /usr/local
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DOCDIR     ?= $(PREFIX)/share/doc/luxfer
INSTALL    ?= install
OBJCOPY    ?= objcopy
DEBUG      ?= split

HEADERS     := luxfer.h luxfer.hpp $(patsubst include/%,%,$(wildcard include/luxfer/*.h)) $(patsubst bindings/cpp/%,%,$(wildcard bindings/cpp/luxfer/*.hpp))
DOCUMENTS   := LICENSE-APACHE LICENSE-MIT README.md $(PROFILE)/THIRD-PARTY.txt
FOLDERS      = $(LIBDIR)/pkgconfig $(LIBDIR)/cmake/luxfer $(INCLUDEDIR)/luxfer $(DOCDIR)
INSTALLED    = $(addprefix $(LIBDIR)/,libluxfer.so libluxfer.so.$(ABI) libluxfer.so.$(VERSION) libluxfer.a pkgconfig/luxfer.pc \
                 $(SYMBOLS) cmake/luxfer/luxferConfig.cmake cmake/luxfer/luxferConfigVersion.cmake) \
               $(addprefix $(INCLUDEDIR)/,$(HEADERS)) $(addprefix $(DOCDIR)/,$(notdir $(DOCUMENTS)))

# relative(from, to): the relative path between two folders, which need not exist.
relative = $(shell realpath -m --relative-to='$(1)' '$(2)')
# fill(template, folder): fills in a template and installs it into the folder.
fill = sed -e 's|@VERSION@|$(VERSION)|g' -e 's|@ABI@|$(ABI)|g' -e 's|@INCLUDEDIR@|$(call relative,$(2),$(INCLUDEDIR))|g' \
         $(1) | $(INSTALL) -m 644 /dev/stdin '$(DESTDIR)$(2)/$(basename $(notdir $(1)))'

# The installed shared library, and the file for its debug symbols.
SHARED    = $(DESTDIR)$(LIBDIR)/libluxfer.so.$(VERSION)
SYMBOLS   = .debug/libluxfer.so.$(VERSION).debug

.PHONY: install uninstall dist

# Builds the library only if it is missing, so that after `make`, `sudo make install` needs no cargo.
$(LIB) $(PROFILE)/libluxfer.a:
	$(MAKE) lib

$(PROFILE)/THIRD-PARTY.txt: Cargo.lock
	@mkdir -p $(@D)
	CARGO='$(CARGO)' bindings/third_party.sh >$@.part && mv $@.part $@

install: $(LIB) $(PROFILE)/libluxfer.a $(PROFILE)/THIRD-PARTY.txt
	$(INSTALL) -d $(foreach folder,$(FOLDERS),'$(DESTDIR)$(folder)')
	$(INSTALL) -m 755 $(LIB) '$(DESTDIR)$(LIBDIR)/libluxfer.so.$(VERSION)'
	ln -sf libluxfer.so.$(VERSION) '$(DESTDIR)$(LIBDIR)/libluxfer.so.$(ABI)'
	ln -sf libluxfer.so.$(ABI) '$(DESTDIR)$(LIBDIR)/libluxfer.so'
	$(INSTALL) -m 644 $(PROFILE)/libluxfer.a '$(DESTDIR)$(LIBDIR)'
ifeq ($(DEBUG),split)
	$(INSTALL) -d '$(DESTDIR)$(LIBDIR)/.debug'
	$(OBJCOPY) --only-keep-debug '$(SHARED)' '$(DESTDIR)$(LIBDIR)/$(SYMBOLS)'
	chmod 644 '$(DESTDIR)$(LIBDIR)/$(SYMBOLS)'
	cd '$(DESTDIR)$(LIBDIR)' && $(OBJCOPY) --strip-debug --add-gnu-debuglink=$(SYMBOLS) libluxfer.so.$(VERSION)
	$(OBJCOPY) --strip-debug '$(DESTDIR)$(LIBDIR)/libluxfer.a'
endif
	$(INSTALL) -m 644 include/luxfer.h bindings/cpp/luxfer.hpp '$(DESTDIR)$(INCLUDEDIR)'
	$(INSTALL) -m 644 include/luxfer/*.h bindings/cpp/luxfer/*.hpp '$(DESTDIR)$(INCLUDEDIR)/luxfer'
	$(INSTALL) -m 644 $(DOCUMENTS) '$(DESTDIR)$(DOCDIR)'
	$(call fill,bindings/pkgconfig/luxfer.pc.in,$(LIBDIR)/pkgconfig)
	$(call fill,bindings/cmake/luxferConfig.cmake.in,$(LIBDIR)/cmake/luxfer)
	$(call fill,bindings/cmake/luxferConfigVersion.cmake.in,$(LIBDIR)/cmake/luxfer)

# Removes the files that `make install` has installed, and their folders if they are then empty.
uninstall:
	rm -f $(foreach file,$(INSTALLED),'$(DESTDIR)$(file)')
	rmdir $(foreach folder,$(FOLDERS) $(LIBDIR)/.debug,'$(DESTDIR)$(folder)') 2>/dev/null || true

dist:
	@mkdir -p out
	git archive --prefix=luxfer-$(VERSION)/ -o out/luxfer-$(VERSION).tar.gz HEAD
	@echo out/luxfer-$(VERSION).tar.gz
